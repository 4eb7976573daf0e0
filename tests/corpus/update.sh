#!/bin/sh
# Writes the messages of today beside the broken files: tests/corpus/update.sh build/dev. Read the difference
# before you commit it.
set -e
RABILINE_UPDATE_CORPUS=1 "$1/tests/unit/input/input_test" --gtest_filter='*BrokenFile*' --gtest_brief=1
