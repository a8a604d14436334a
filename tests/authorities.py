"""Certificate authorities of tests, and what they sign for roles: folders of credentials."""

from datetime import timedelta
from pathlib import Path

from actum_deployer.certificates import new_authority, new_certificate, now


class Authority:
    """An authority that signs in a folder of its own."""

    def __init__(self, folder: Path) -> None:
        folder.mkdir()
        self._folder = folder
        self._signed = new_authority("authority", now())
        (folder / "ca.pem").write_bytes(self._signed.certificate_pem)

    def role(self, name: str, host: str = "localhost", days_left: int = 1) -> Path:
        """Sign a certificate for a role, and return the folder of its credentials."""
        role = self._folder / name
        role.mkdir()
        signed = new_certificate(self._signed, name, now() - timedelta(days=2), days_left + 2, [host])
        for file, content in (("certificate", signed.certificate_pem), ("key", signed.key_pem)):
            (role / f"{file}.pem").write_bytes(content)
        (role / "ca.pem").write_bytes(self._signed.certificate_pem)
        return role
