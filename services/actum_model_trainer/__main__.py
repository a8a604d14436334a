"""`python -m actum_model_trainer`."""

from actum.runtime import needs_extra, run

with needs_extra("model-trainer"):
    from actum_model_trainer.settings import Settings
    from actum_model_trainer.teaching.trainer import ModelTrainer


def main() -> None:
    """Serve until SIGTERM."""
    run(Settings, ModelTrainer.configured)


if __name__ == "__main__":
    main()
