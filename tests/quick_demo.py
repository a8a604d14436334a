"""`actum`, whose demo learns little in little time: for tests of what comes after."""

from actum_command import __main__
from actum_command.demo import marked
from models import QUICK

if __name__ == "__main__":
    marked.DEFAULT, marked.TRAINING_REPETITIONS = QUICK, 2
    __main__.main()
