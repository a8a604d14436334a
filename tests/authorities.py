"""Certificate authorities of tests and what they sign, made by the program openssl; and roles' folders of them."""

import shutil
import subprocess
from pathlib import Path

OPENSSL = shutil.which("openssl")
NEW_KEY = ("req", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:P-256", "-nodes")
ENDED = ("-days", "-1")
"""Options of a certificate that expired yesterday."""


def openssl(folder: Path, *arguments: str) -> None:
    subprocess.run([str(OPENSSL), *arguments], cwd=folder, check=True, capture_output=True)


class Authority:
    """An authority in a folder of its own."""

    def __init__(self, folder: Path) -> None:
        folder.mkdir()
        self._folder = folder
        openssl(folder, *NEW_KEY, "-x509", "-subj", "/CN=authority", "-keyout", "ca.key", "-out", "ca.pem")

    def role(self, name: str, *options: str, host: str = "localhost") -> Path:
        """Sign a certificate for a role, and return the folder of its credentials."""
        role = self._folder / name
        role.mkdir()
        (role / "names").write_text(f"subjectAltName=DNS:{host}\nbasicConstraints=CA:FALSE\n")
        openssl(role, *NEW_KEY, "-subj", f"/CN={name}", "-keyout", "key.pem", "-out", "request.pem")
        signed = ("-CA", "../ca.pem", "-CAkey", "../ca.key", "-CAcreateserial", "-extfile", "names", *options)
        openssl(role, "x509", "-req", "-in", "request.pem", "-out", "certificate.pem", *signed)
        shutil.copy(self._folder / "ca.pem", role)
        return role
