"""Hook of mkdocs (mkdocs.yml): replaces links to files outside of docs/ by their text; the site lacks these files."""
import pathlib
import re

LINK = re.compile(r"(?<!!)\[([^\]]*)\]\((\.\./[^)\s]*)\)")


def on_page_markdown(markdown: str, page, config, **_) -> str:
    docs = pathlib.Path(config["docs_dir"]).resolve()
    folder = (docs / page.file.src_path).parent

    def kept(link: re.Match) -> str:
        target = (folder / link[2].partition("#")[0]).resolve()
        return link[0] if target.is_relative_to(docs) else link[1]

    return LINK.sub(kept, markdown)
