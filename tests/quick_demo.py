"""`actum`, whose demo learns little in little time: for tests of what comes after."""

from actum_command import __main__, demo
from models import QUICK

if __name__ == "__main__":
    demo.DEFAULT, demo.TRAINING_REPETITIONS = QUICK, 2
    __main__.main()
