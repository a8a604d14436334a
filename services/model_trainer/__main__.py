"""`python -m model_trainer`."""

from actum.runtime import needs_extra, run

with needs_extra("model-trainer"):
    from model_trainer.settings import Settings
    from model_trainer.trainer import ModelTrainer


def main() -> None:
    """Serve until SIGTERM."""
    run(Settings, ModelTrainer.configured)


if __name__ == "__main__":
    main()
