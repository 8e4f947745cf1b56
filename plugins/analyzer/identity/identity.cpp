// analyzer.identity as a plugin. See README.md.
#include "identity_analyzer.hpp"

PELORUS_PLUGIN(analyzer_identity::IdentityAnalyzer, "analyzer.identity");
