#!/bin/bash
# A newcomer's changes touch few files and work at once (newcomer.py says which).
cd "$(dirname "$0")/../.." || exit 2
exec python3 tests/project/newcomer.py
