// waveform.lookahead: the pulse that begins the best sequence of several. See README.md.
#include "lookahead.hpp"

PELORUS_PLUGIN(lookahead::Lookahead, "waveform.lookahead");
