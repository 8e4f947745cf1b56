// sink.csv as a plugin. See README.md.
#include "csv_sink.hpp"

PELORUS_PLUGIN(sink_csv::CsvSink, "sink.csv");
