#include "external.hpp"

PELORUS_PLUGIN(source_external::ExternalSource, "source.external");
