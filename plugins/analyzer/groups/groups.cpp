// analyzer.groups: how many groups there are, and who came from whom. See README.md.
#include "group_analyzer.hpp"

PELORUS_PLUGIN(analyzer_groups::GroupAnalyzer, "analyzer.groups");
