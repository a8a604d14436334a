"""Teaching by commands: sets of recorded examples, jobs that train and test, models in use.

`trainer` is the service's node. `set_commands`, `take_commands`, `example_commands`, `job_commands` and
`model_commands` are its commands, in `requests` and `replies` their fields. `set_store`, `model_store`, `upload_store`
and `job_store` keep files; `job_process` runs `job` as a process of its own.
"""
