"""A service's health as a file."""

import os
import subprocess
import sys
import time

import pytest

from actum.health import FRESH_S, HealthFile, is_healthy


def test_healthy_from_the_moment_it_is_said_until_it_is_taken_back(tmp_path):
    file = tmp_path / "health"
    assert not is_healthy(file)
    HealthFile(file).write(healthy=True)
    assert is_healthy(file)
    HealthFile(file).write(healthy=False)
    assert not is_healthy(file)


def test_what_was_said_long_ago_does_not_count(tmp_path):
    file = tmp_path / "health"
    HealthFile(file).write(healthy=True)
    long_ago_s = time.monotonic() - FRESH_S - 1
    os.utime(file, (long_ago_s, long_ago_s))
    assert not is_healthy(file)


def test_where_no_file_can_be_nobody_is_healthy(tmp_path):
    (tmp_path / "file").touch()
    assert not is_healthy(tmp_path / "file" / "health")


@pytest.mark.parametrize("healthy", [True, False])
def test_the_check_exits_0_only_when_healthy(tmp_path, healthy):
    HealthFile(tmp_path / "health").write(healthy)
    check = subprocess.run(
        [sys.executable, "-m", "actum.health"],
        env={**os.environ, "ACTUM_HEALTH_FILE": str(tmp_path / "health")},
        check=False,
    )
    assert check.returncode == (0 if healthy else 1)


def test_the_check_imports_nothing_that_is_slow_to_import():
    program = "import sys, actum.health; print({'zenoh', 'numpy', 'pydantic'} & set(sys.modules))"
    assert subprocess.check_output([sys.executable, "-c", program], text=True) == "set()\n"
