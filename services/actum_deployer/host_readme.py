"""The README of a host's folder, and the file for the user's own settings: what to do there."""

from datetime import date

from actum.installing import WHEEL, pip_install
from actum_deployer.credential_folders import CREDENTIALS, SERVICES_USER
from actum_deployer.deployment import Deployment
from actum_deployer.hosts import Host
from actum_deployer.programs import FILES, INSTALLED, ROUTER_FILE, SETTINGS, programs
from actum_deployer.roles import BRIDGE
from actum_deployer.systemd_units import VENV

UNITS = "systemd"
"""The folder of the units, in that of a host."""
USERS, OWNERS = "sysusers.conf", "tmpfiles.conf"
"""The files, in that folder, of the programs' users and of who owns what."""

README = """\
# {name}, {address}

Made by `actum deploy init`. Runs here:

{table}

{link}

{secured}
## With containers

The images `actum/…` come from `docker compose build` in actum's repository, that of a camera from
`ACTUM_POSE_MODEL=$PWD/pose.task docker compose -f deploy/compose.camera-host.yml build` there; or all of them by
`docker save` and `docker load` from a machine that has them.

```sh
sudo chown -R {user}:{user} {credentials}    # the services' user, and nobody else, may read the private keys
docker compose up --detach
docker compose ps                            # all healthy after some seconds
docker compose down
```
{bridge}
## Without containers

```sh
sudo cp -r . {installed}
sudo cp {units}/{users} /etc/sysusers.d/actum.conf && sudo systemd-sysusers
sudo cp {units}/{owners} /etc/tmpfiles.d/actum.conf && sudo systemd-tmpfiles --create actum.conf
sudo python3 -m venv {venv} && sudo {venv}/bin/{install}     # a wheel of `make wheel`, copied here
sudo cp {units}/*.service /etc/systemd/system/ && sudo systemctl daemon-reload
sudo systemctl enable --now {unit_names}
```

Each program runs as a user of its own, who can read its credentials and no others. What was renewed is installed by
`sudo cp -r {renewed} {installed}`, which leaves settings of yours as they are. Whenever you have copied credentials
or settings here again, `sudo systemd-tmpfiles --create actum.conf` hands them over. Models, recordings of what was
taught, and the last answers lie in a folder for each program below `/var/lib/actum`. Users and owners are tested with
systemd's own tools, and `systemd-analyze verify` accepts the units, but no systemd has run them yet.

## Settings

`{settings}` holds those of yours, for both ways. `actum deploy` writes it once; whoever copies this whole folder here
again replaces it. All programs of this host get them. What only one may have, such as the page's token or a camera's
password, goes into `NAME.env` with that service's name, such as `web_dashboard.env`, mode 0600. Files that the
settings name, such as a pose model, a calibration or a scene file, lie in `{files}`, which is `{installed}/{files}`
to the services.
"""

SECURED = """\
Credentials are valid until {expiry}. Before that, renew them with `actum deploy rotate`, and copy `{credentials}`
here again, not the whole folder, which would replace `{settings}`. Hand them over as below. The router notices and
listens anew, and services show the new ones as they connect to it again: nothing has to be stopped. After `actum
deploy rotate --revoke NAME` copy `router.json5` as well, which says what is not believed any more; a router in a
container then needs `docker compose restart router`.

"""
OPEN = (
    "**TLS, passwords and access control are disabled**: every program that reaches this router may read and "
    "write everything. Use a trusted network.\n\n"
)
NO_IMAGE = """
No image has the bridge to ROS 2 yet: run it as below, beside the containers.
"""
SETTINGS_OF = {
    "camera": """\
ACTUM_SOURCE=camera
ACTUM_CAMERA=/dev/video0
# of `actum models fetch`
ACTUM_POSE_MODEL=/etc/actum/files/pose.task
# of `actum calibrate`
#ACTUM_CALIBRATION=/etc/actum/files/camera.yaml
# what carries which marker
#ACTUM_SCENE=/etc/actum/files/objects.yaml
""",
    "compute": """\
#ACTUM_FALSE_ALARMS_PER_MIN=1
""",
}
"""What the file for settings holds at first, by kind of host."""
SIMULATED_SETTINGS = """\
ACTUM_EVERYDAY=all
ACTUM_PAUSES=short
ACTUM_OBJECTS='{"1": {"name": "cup"}, "2": {"name": "box"}, "3": {"name": "book"}}'
"""
"""The same where the simulated scene stands in the place of a camera."""


def readme(deployment: Deployment, host: Host, expiry: date) -> str:
    """Return the README of a host, whose credentials are valid until a day."""
    running = list(programs(deployment, host))
    rows = [f"| `{each.name}` | {each.about} | {each.sensor} |" for each in running]
    of_router = [ROUTER_FILE] if host in deployment.routers else []
    return README.format(
        name=host.name,
        address=host.address,
        table="\n".join(["| service | what it is | sensor |", "|---|---|---|", *rows]),
        link=_link(deployment, host),
        secured=SECURED.format(expiry=expiry, credentials=CREDENTIALS, user=SERVICES_USER, settings=SETTINGS)
        if deployment.secured
        else OPEN,
        user=SERVICES_USER,
        credentials=CREDENTIALS if deployment.secured else "files",
        bridge=NO_IMAGE if any(program.role is BRIDGE for program in running) else "",
        installed=INSTALLED,
        venv=VENV,
        install=pip_install("all", WHEEL),
        renewed=" ".join([*([CREDENTIALS] if deployment.secured else []), *of_router, UNITS]),
        units=UNITS,
        users=USERS,
        owners=OWNERS,
        unit_names=" ".join(f"actum-{program.name}" for program in running),
        settings=SETTINGS,
        files=FILES,
    )


def settings_file(deployment: Deployment, host: Host) -> str:
    """Return what the file for the user's settings holds at first."""
    if not deployment.simulated or host.kind != "camera":
        return SETTINGS_OF[host.kind]
    number = deployment.sensors.index(host.sensors[0])
    return SIMULATED_SETTINGS + (f"ACTUM_SEED={number + 1}\n" if number else "")  # each sensor sees another scene


def _link(deployment: Deployment, host: Host) -> str:
    """Say who has to reach whom on which port."""
    if host not in deployment.routers:
        return f"The services connect to the router at {deployment.routers[0].endpoint}; no port is open here."
    earlier = deployment.routers[: deployment.routers.index(host)]
    later = [each.name for each in deployment.hosts if each != host and each not in earlier]
    reached = f"TCP port {host.port} has to be reachable from {', '.join(later)}." if later else ""
    dialled = f"The router connects to {', '.join(f'{each.name} at {each.endpoint}' for each in earlier)}."
    cross = deployment.images_cross or not deployment.secured  # nothing but access control holds images back
    images = "Images go from host to host." if cross else "Images do not leave the camera's host."
    return " ".join(filter(None, [reached, dialled if earlier else "", images]))
