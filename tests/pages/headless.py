"""Chromium without a window, and what the tests ask it."""

from __future__ import annotations

import json
import time
from pathlib import Path
from typing import Any

from selenium import webdriver
from selenium.webdriver.chrome.service import Service
from selenium.webdriver.common.by import By

import machine

OPTIONS = (
    "--headless=new",
    "--no-sandbox",  # it only sees pages of ours, and root may not have one
    "--disable-gpu",
    "--disable-dev-shm-usage",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
)
PATIENCE = 30.0  # longest that a page may take [s]


def programs() -> tuple[str, str]:
    """Chromium and its driver."""
    return machine.program("chromium"), machine.program("chromedriver")


class Browser:
    """One window."""

    def __init__(self, programs: tuple[str, str], profile: Path) -> None:
        options = webdriver.ChromeOptions()
        options.binary_location = programs[0]
        for option in (*OPTIONS, f"--user-data-dir={profile}"):
            options.add_argument(option)
        options.set_capability("goog:loggingPrefs", {"browser": "ALL", "performance": "ALL"})
        self.driver = webdriver.Chrome(options=options, service=Service(programs[1]))

    def open(self, page: Path, width: int) -> None:
        """Open a page, and wait until its pictures are drawn."""
        size = {"width": width, "height": 900, "deviceScaleFactor": 1, "mobile": False}
        self.driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", size)
        for kind in ("browser", "performance"):
            self.driver.get_log(kind)  # what came before
        self.driver.get(page.as_uri())
        drawn = (
            "const e = document.getElementById('explorer');"
            "return document.readyState === 'complete' && (!e || e.dataset.state === 'ready')"
        )
        self.wait(drawn)

    def wait(self, condition: str) -> None:
        """Wait until a script returns something true."""
        end = time.monotonic() + PATIENCE
        while not self.run(condition):
            assert time.monotonic() < end, f"{condition} never came true: {self.complaints()}"
            time.sleep(0.05)

    def run(self, script: str, *arguments: Any) -> Any:
        """Run a script in the page."""
        return self.driver.execute_script(script, *arguments)

    def all(self, selector: str, inside: Any = None) -> list[Any]:
        """Elements of the page, or inside of one of them."""
        return (inside or self.driver).find_elements(By.CSS_SELECTOR, selector)

    def complaints(self) -> list[str]:
        """What the page wrote to the console: errors and warnings."""
        return [entry["message"] for entry in self.driver.get_log("browser")]

    def requests(self) -> list[str]:
        """What the page asked the network for: not itself, nor what it holds."""
        urls = []
        for entry in self.driver.get_log("performance"):
            message = json.loads(entry["message"])["message"]
            if message["method"] == "Network.requestWillBeSent":
                urls.append(message["params"]["request"]["url"])
        own = ("file:", "data:", "blob:", "chrome:")
        return [url for url in urls if not url.startswith(own)]
