#!/bin/sh
# What packs say of themselves: from options and sources, shown, exported, baked again.
exec /usr/bin/python3 "$(dirname "$0")/bake_about.py"
