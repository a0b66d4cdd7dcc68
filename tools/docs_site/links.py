"""Links of a built site: every target is a file of the site, every anchor is on its page."""

from __future__ import annotations

from collections.abc import Iterator
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit


class _Page(HTMLParser):
    """Links, anchors and loaded files of a page."""

    def __init__(self) -> None:
        super().__init__()
        self.links: list[str] = []
        self.loaded: list[str] = []
        self.anchors: set[str] = set()

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        for name, value in attrs:
            if value is None:
                continue
            if name in ("id", "name"):
                self.anchors.add(value)
            elif name == "href" and tag == "a":
                self.links.append(value)
            elif name == "src" or (name == "href" and tag == "link"):
                self.loaded.append(value)


def read(path: Path) -> _Page:
    """Parse a page."""
    page = _Page()
    page.feed(path.read_text(encoding="utf-8"))
    return page


def broken(site: Path) -> list[str]:
    """Broken links of a site, and files that its pages load from elsewhere; one line each."""
    pages = {path: read(path) for path in sorted(site.rglob("*.html"))}
    return [line for path in pages for line in _faults(site, path, pages)]


def _faults(site: Path, path: Path, pages: dict[Path, _Page]) -> Iterator[str]:
    name = path.relative_to(site)
    for target in pages[path].loaded:
        if urlsplit(target).netloc:
            yield f"{name}: loads {target} from the network"
    for target in [*pages[path].links, *pages[path].loaded]:
        parts = urlsplit(target)
        if parts.scheme or parts.netloc:
            continue
        linked = (path.parent / unquote(parts.path)).resolve() if parts.path else path
        if not linked.is_file():
            yield f"{name}: {target} does not exist"
        elif (
            parts.fragment
            and linked in pages
            and unquote(parts.fragment) not in pages[linked].anchors
        ):
            yield f"{name}: {target}: no such anchor"
