# Puts Alcove into Nuke's menu. If you have a menu.py, add these lines to it.
# SPDX-License-Identifier: BSD-3-Clause
import nuke

import alcove_nuke

nuke.menu("Nuke").addMenu("Alcove").addCommand("Ambient Occlusion...", alcove_nuke.compute)
