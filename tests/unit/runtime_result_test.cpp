#include <catch2/catch.hpp>

#include "runtime/result.hpp"
#include "runtime_fakes.hpp"

using fakes::Table;
using pelorus::runtime::ResultCollector;

TEST_CASE("tables stand by node in file order, then by name, and the same name replaces", "[runtime][results]") {
    ResultCollector collector;
    collector.collect(1, "shape", Table("b", {0, 1}).body);
    collector.collect(0, "errors", Table("z", {0, 1}).body);
    Table other("a", {0, 2});
    other.scalar.name = "other";
    collector.collect(1, "shape", other.body);
    collector.collect(1, "shape", Table("b", {0, 3, 1, 4}).body);
    std::vector<std::string> names;
    for (const auto& table : collector.results().tables) names.push_back(table.node + '.' + table.name);
    CHECK(names == std::vector<std::string>{"errors.z", "shape.a", "shape.b"});
    CHECK(collector.results().tables[2].rows == std::vector<double>{0, 3, 1, 4});
    CHECK(collector.results().tables[2].row_count() == 2);
    CHECK(collector.results().tables[2].scalars[0].column == "error");
    CHECK(collector.results().tables[2].scalars[0].weight == 1);
}

TEST_CASE("a scalar's name is free only once in all tables of a node", "[runtime][results]") {
    ResultCollector collector;
    collector.collect(0, "errors", Table("one", {0, 1}).body);
    collector.collect(1, "shape", Table("one", {0, 1}).body);
    CHECK_THROWS_WITH(collector.collect(0, "errors", Table("two", {0, 1}).body),
                      "tables \"one\" and \"two\" have a scalar of the same name rmse");
    CHECK(collector.results().tables.size() == 2);
}
