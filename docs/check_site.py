"""Check the built site: internal links lead somewhere, nothing is fetched, no address is shown.

``python docs/check_site.py site`` prints what is wrong and ends with 1 if anything is.
"""

import sys
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

LOADING = {"script": "src", "img": "src", "iframe": "src", "source": "src", "link": "href"}
"""What a browser fetches by itself."""


class SitePage(HTMLParser):
    """The links, the anchors and the resources of a page."""

    def __init__(self, path: Path) -> None:
        super().__init__()
        self.links: list[str] = []
        self.anchors: set[str] = {""}
        self.fetched: list[str] = []
        self.addresses = 0
        self.feed(path.read_text(encoding="utf-8"))

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Take note of one element."""
        found = {name: value for name, value in attrs if value is not None}
        self.anchors |= {found[name] for name in ("id", "name") if name in found}
        if tag == "a" and "href" in found:
            self.links.append(found["href"])
        if tag in LOADING and LOADING[tag] in found and found.get("rel") != "canonical":
            self.fetched.append(found[LOADING[tag]])

    def handle_data(self, data: str) -> None:
        """Count what is shown as an object at an address in memory, another one in each build."""
        self.addresses += data.count(" object at 0x")


def faults(site: Path) -> list[str]:
    """Return one sentence for each link, anchor, resource or address that is wrong."""
    pages = {
        path.resolve(): SitePage(path)
        for path in sorted(site.rglob("*.html"))
        if "_static" not in path.parts
    }
    found = []
    for path, page in pages.items():
        where = path.relative_to(site.resolve())
        if page.addresses:
            found.append(f"{where} shows the address of an object.")
        for target in page.links + page.fetched:
            parts = urlsplit(target)
            if parts.scheme in ("data", "mailto", "javascript"):
                continue
            if parts.scheme or parts.netloc:
                if target in page.fetched:
                    found.append(f"{where} fetches {target} from the network.")
                continue
            aim = (path.parent / unquote(parts.path)).resolve() if parts.path else path
            aim = aim / "index.html" if aim.is_dir() else aim
            if not aim.is_file():
                found.append(f"{where} links to {target}, which is not there.")
            elif "=" in parts.fragment:  # what a page is to show, and no place
                continue
            elif aim in pages and unquote(parts.fragment) not in pages[aim].anchors:
                found.append(f"{where} links to {target}, and there is no such place.")
    return found


def main() -> int:
    """Print what is wrong."""
    site = Path(sys.argv[1])
    wrong = faults(site)
    print(*wrong, sep="\n", end="\n" if wrong else "")
    return 1 if wrong or not (site / "index.html").is_file() else 0


if __name__ == "__main__":
    sys.exit(main())
