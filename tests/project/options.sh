#!/bin/bash
# Every option of every program, tried from its row: options.py says how.
cd "$(dirname "$0")/../.." || exit 2
exec python3 tests/project/options.py
