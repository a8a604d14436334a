"""The router of SECURITY.md lets in who has a certificate, and nobody else."""

import os
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
import zenoh

from live import PATIENCE_S, free_endpoint, wait_until

CONFIGURATIONS = Path(__file__).parents[2] / "deploy" / "zenoh"
OPENSSL = shutil.which("openssl")
KEY = ("req", "-newkey", "rsa:2048", "-nodes", "-subj", "/CN=localhost")
pytestmark = [pytest.mark.system, pytest.mark.skipif(OPENSSL is None, reason="openssl makes the certificates")]


def openssl(folder: Path, *arguments: str) -> None:
    subprocess.run([str(OPENSSL), *arguments], cwd=folder, check=True, capture_output=True)


@pytest.fixture(scope="module")
def certificates(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the certificates that the configurations name, and one that another authority signed."""
    folder = tmp_path_factory.mktemp("certificates")
    (folder / "names").write_text("subjectAltName=DNS:localhost\nbasicConstraints=CA:FALSE\n")
    for authority, owners in {"ca": ("router", "client"), "other": ("stranger",)}.items():
        openssl(folder, *KEY, "-x509", "-keyout", f"{authority}.key", "-out", f"{authority}.pem")
        for owner in owners:
            openssl(folder, *KEY, "-keyout", f"{owner}.key", "-out", f"{owner}.csr")
            signed = ("-CA", f"{authority}.pem", "-CAkey", f"{authority}.key", "-CAcreateserial", "-extfile", "names")
            openssl(folder, "x509", "-req", "-in", f"{owner}.csr", "-out", f"{owner}.pem", *signed)
    return folder


def actum(folder: Path, endpoint: str, configuration: Path | None, *arguments: str) -> subprocess.Popen[str]:
    named = {"ACTUM_ZENOH_CONFIG": str(configuration)} if configuration else {}
    return subprocess.Popen(
        [sys.executable, "-m", "actum_command", *arguments],
        cwd=folder,
        env={**os.environ, "ACTUM_CONNECT": endpoint, **named},
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    )


@pytest.fixture
def router(certificates: Path) -> Iterator[str]:
    """The endpoint of a router as the page runs it."""
    endpoint = free_endpoint().replace("tcp/127.0.0.1", "tls/localhost")
    configuration = CONFIGURATIONS / "router.mtls.json5"
    process = actum(certificates, endpoint, None, "router", "--config", str(configuration), "--listen", endpoint)
    assert process.stdout
    wait_until(lambda: "listens on" in process.stdout.readline(), "the router listens")
    yield endpoint
    process.terminate()
    process.communicate(timeout=PATIENCE_S)


def test_who_has_a_certificate_of_the_authority_is_let_in(certificates: Path, router: str) -> None:
    process = actum(certificates, router, CONFIGURATIONS / "client.mtls.json5", "doctor")
    assert "action_fusion is not running" in process.communicate(timeout=PATIENCE_S)[0]


def test_who_has_none_or_a_foreign_one_is_not(certificates: Path, router: str) -> None:
    configured = (CONFIGURATIONS / "client.mtls.json5").read_text()
    without, foreign = certificates / "without.json5", certificates / "foreign.json5"
    without.write_text('{transport: {link: {tls: {root_ca_certificate: "ca.pem"}}}}')
    foreign.write_text(configured.replace("client.", "stranger."))
    asked = [actum(certificates, router, configuration, "doctor") for configuration in (without, foreign, None)]
    for process in asked:
        assert "no router answers" in process.communicate(timeout=PATIENCE_S)[0]


def test_but_for_the_certificates_the_router_is_the_usual_one() -> None:
    usual, safe = (zenoh.Config.from_file(CONFIGURATIONS / f"{name}.json5") for name in ("router", "router.mtls"))
    for path in ("mode", "scouting", "transport/shared_memory", "transport/link/tx", "adminspace"):
        assert safe.get_json(path) == usual.get_json(path), path
