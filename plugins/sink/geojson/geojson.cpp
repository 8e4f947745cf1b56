// sink.geojson as a plugin. See README.md.
#include "geojson_sink.hpp"

PELORUS_PLUGIN(sink_geojson::GeoJsonSink, "sink.geojson");
