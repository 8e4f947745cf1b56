#!/usr/bin/sed -Ef
# Doxygen reads comments that begin with two stars. A comment behind code belongs to that code, one at the top to the file, any
# other to what follows.
1s|^/\* |/** @file\n * |
1s|^/// |/// @file\n/// |
s|^( *)/\* |\1/** |
s|([^ ].*) /\* (.*)$|\1 /**< \2|
