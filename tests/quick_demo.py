"""`actum`, whose demo learns little in little time: for tests of what comes after."""

from actum_command import __main__, simulated_experiment
from models import QUICK

if __name__ == "__main__":
    simulated_experiment.DEFAULT, simulated_experiment.TRAINING_REPETITIONS = QUICK, 2
    __main__.main()
