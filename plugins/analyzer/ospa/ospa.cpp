// analyzer.ospa: a set of tracks against a set of objects. See README.md.
#include "ospa.hpp"

PELORUS_PLUGIN(ospa::Ospa, "analyzer.ospa");
