#!/usr/bin/env python3
"""Renames the types of an IDL file as ROS 2 names them in DDS: pkg::msg::dds_::Name_.

Usage: cyclone_idl.py IN.idl OUT.idl
fastddsgen has an option for it; the generator of Cyclone DDS takes names as they are.
"""
import pathlib
import re
import sys

text = pathlib.Path(sys.argv[1]).read_text(encoding="utf-8")
text = re.sub(r"^(.*module (?:msg|srv) \{)$", r"\1 module dds_ {", text, flags=re.M)
text = re.sub(r"^(\}; (?:\};|module srv \{ module dds_ \{))", r"}; \1", text, flags=re.M)
text = re.sub(r"(\w+::\w+::)(\w+)", r"\1dds_::\2_", text)
text = re.sub(r"struct (\w+) ", r"struct \1_ ", text)
pathlib.Path(sys.argv[2]).write_text(text, encoding="utf-8")
