"""What the page costs: the service's share of a core, and what the pipeline loses meanwhile (make bench-page).

The simulated scene runs at 30 frames/s with images and both maps, one process per service. After some seconds without
readers, three programs read the page's WebSocket as browsers do; then a fourth stops reading; then three Chromiums show
the page, which draw in software where there is no graphics card and so take the cores from everybody.
"""

import shutil
import threading
import time
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, ExitStack, contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from urllib.parse import urlsplit

import psutil
from playwright.sync_api import sync_playwright
from rich.console import Console
from rich.table import Table
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import ClientConnection, connect

from actum import keys
from actum.messages import Status
from actum.runtime import Client, Listening
from actum.settings import ServiceSettings
from actum_command import processes
from actum_command.demo.marked import train_model
from actum_command.model_in_use import ModelInUse
from actum_command.service_settings import Given
from actum_command.supervising import Supervisor
from actum_model_trainer.progress import silent

SETTINGS = ServiceSettings(connect="tcp/127.0.0.1:7458")
SCENE: Given = {"everyday": ["all"], "pauses": ["short"]}
"""Actions are marked, and everyday doings come between."""
READERS = 3
SETTLE_S, MEASURE_S = 5.0, 30.0
PIPELINE = ("pose_preprocessor", "som_classifier", "action_fusion", "marker_tracker")


def main() -> None:
    """Run everything and print the table."""
    table = Table(title=f"{MEASURE_S:g} s each, one core is 100 %")
    for heading in ("who reads the page", "service", "frames lost by the pipeline", "messages/s a reader gets"):
        table.add_column(heading, justify="left" if heading.startswith("who") else "right")
    with TemporaryDirectory() as name, live(Path(name)) as (client, address):
        statuses = client.listen(keys.pattern(keys.STATUS))
        for who, opened in SITUATIONS.items():
            with opened(address) as received:
                table.add_row(who, *measured(statuses, received))
    Console(highlight=False, width=110).print(table)


@contextmanager
def live(folder: Path) -> Iterator[tuple[Client, str]]:
    """Run the whole system; yield a client of it and the page's address."""
    model = folder / "model.npz"
    train_model(folder / "training.mcap", model, silent)
    with Supervisor(folder / "log") as supervisor:
        supervisor.start(processes.router(SETTINGS))
        with Client(SETTINGS, wait_s=30.0) as client:
            system = processes.system(SETTINGS, "simulator", ModelInUse(model), SCENE)
            supervisor.start(*processes.with_page(SETTINGS, [*system, processes.scene(SETTINGS)]))
            while not (pages := [info.page for info in client.infos() if info.page]):
                time.sleep(0.1)
            yield client, pages[0]


@contextmanager
def nobody(_address: str) -> Iterator[Counter[int]]:
    """Have nobody read."""
    yield Counter()


@contextmanager
def programs(address: str) -> Iterator[Counter[int]]:
    """Have programs read the page's WebSocket; yield how many messages each has got."""
    received: Counter[int] = Counter()
    with ExitStack() as stack:
        for number in range(READERS):
            socket = stack.enter_context(connect(f"ws://{urlsplit(address).netloc}/ws", max_size=None))
            threading.Thread(target=_read, args=(socket, received, number), daemon=True).start()
        yield received


def _read(socket: ClientConnection, received: Counter[int], number: int) -> None:
    try:
        for message in socket:
            received[number] += message.count("\n") + 1 if isinstance(message, str) else 1
    except ConnectionClosed:
        return


@contextmanager
def programs_and_a_stalled_one(address: str) -> Iterator[Counter[int]]:
    """Have one more connected that reads nothing."""
    with (
        connect(f"ws://{urlsplit(address).netloc}/ws", max_size=None, max_queue=1, close_timeout=0),
        programs(address) as received,
    ):
        yield received


@contextmanager
def browsers(address: str) -> Iterator[Counter[int]]:
    """Have Chromiums show the page."""
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=shutil.which("chromium"))
        for _ in range(READERS):
            browser.new_page().goto(address)
        yield Counter()
        browser.close()


SITUATIONS: dict[str, Callable[[str], AbstractContextManager[Counter[int]]]] = {
    "nobody": nobody,
    f"{READERS} programs": programs,
    f"{READERS} programs, and one that has stalled": programs_and_a_stalled_one,
    f"{READERS} Chromiums": browsers,
}
"""Who reads the page, and how they are opened."""


def measured(statuses: Listening, received: Counter[int]) -> tuple[str, str, str]:
    """Measure for a while: the service's share of a core, the pipeline's losses, what each reader gets."""
    service = next(each for each in psutil.Process().children() if "web_dashboard" in each.cmdline())
    time.sleep(SETTLE_S)
    lost_before, got_before = lost(statuses), received.copy()
    service.cpu_percent()
    time.sleep(MEASURE_S)
    share = service.cpu_percent()
    lost_here = lost(statuses) - lost_before
    got = [(received[reader] - got_before[reader]) / MEASURE_S for reader in received]
    losses = ", ".join(f"{count} of {key}" for key, count in lost_here.items())
    return f"{share:.1f} %", losses or "none", f"{min(got):.0f}" if got else ""


def lost(statuses: Listening) -> Counter[str]:
    """Read what the pipeline's services have said up to now; return the frames that they lost on the way, by key."""
    newest: dict[str, Status] = {}
    while (each := statuses.receive()) is not None:
        if isinstance(each.message, Status):
            newest[each.message.service] = each.message
    lost_frames: Counter[str] = Counter()
    for service in PIPELINE:
        lost_frames.update(newest[service].drops)
    return lost_frames


if __name__ == "__main__":
    main()
