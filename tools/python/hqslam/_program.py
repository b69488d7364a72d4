"""The console command hqslam: the program itself, which takes this process over."""

import os
import sys
from typing import NoReturn

from . import program


def main() -> NoReturn:
    os.execv(program, ["hqslam", *sys.argv[1:]])
