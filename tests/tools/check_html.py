"""Parses pages strictly by html5lib and lists everything that they would load.

usage: check_html.py PAGE...
"""

import re
import sys

import html5lib

LOADING = re.compile(r"""(?:@import|url\()\s*['"]?(?!data:|#)""")

for path in sys.argv[1:]:
    text = open(path, encoding="utf8").read()
    tree = html5lib.HTMLParser(strict=True, namespaceHTMLElements=False).parse(text)
    ids = [element.get("id") for element in tree.iter() if element.get("id")]
    assert len(ids) == len(set(ids)), f"{path}: ids are not unique: {sorted({i for i in ids if ids.count(i) > 1})}"
    for element in tree.iter():
        for name in ("src", "href", "data", "poster", "srcset", "xlink:href"):
            target = element.get(name)
            external = target and not target.startswith(("#", "data:"))
            # A link is followed by the reader alone.
            assert not external or element.tag == "a", f"{path}: {element.tag} loads {target}"
        if element.tag == "style":
            assert not LOADING.search(element.text or ""), f"{path}: a style loads a file"
    print(f"{path}: valid, {len(ids)} ids, nothing loaded")
