// `pelorus new`: what it makes and what it refuses. That the projects build and run is in template_test.cpp.
#include <catch2/catch.hpp>

#include "../fixtures/temporary_folder.hpp"
#include "../support/process.hpp"

using namespace pelorus::test;
using Catch::Contains;

TEST_CASE("a new project is complete and says what to do next") {
    const TemporaryFolder folder;
    const Ended ended = pelorus_command({"new", "motion", "slow_drag", "--dir", folder.path().string()});
    CHECK(ended.err.empty());
    REQUIRE(ended.exit == 0);
    for (const char* step : {"cmake -B build", "cmake --build build", "pelorus run config.yaml --plugins build"})
        CHECK_THAT(ended.out, Contains(step));
    for (const char* name : {"CMakeLists.txt", "README.md", "config.yaml", "slow_drag.cpp", ".gitignore"}) {
        CAPTURE(name);
        REQUIRE(folder.has(std::string("slow_drag/") + name));
        const std::string text = folder.read(std::string("slow_drag/") + name);
        for (const char* left : {"@NAME@", "@CLASS@", "@KIND@", "@ID@", "@NOTES@"}) CHECK(count(text, left) == 0);
    }
    const std::string source = folder.read("slow_drag/slow_drag.cpp");
    CHECK_THAT(source, Contains("PELORUS_PLUGIN(SlowDragMotion, \"org.example.motion.slow_drag\")"));
}

TEST_CASE("an existing folder is left alone") {
    const TemporaryFolder folder;
    folder.write("mine", "precious");
    const Ended ended = pelorus_command({"new", "sink", "mine", "--dir", folder.path().string()});
    CHECK(ended.exit == 2);
    CHECK(folder.read("mine") == "precious");
    REQUIRE(pelorus_command({"new", "sink", "other", "--dir", folder.path().string()}).exit == 0);
    const Ended again = pelorus_command({"new", "source", "other", "--dir", folder.path().string()});
    CHECK(again.exit == 2);
    CHECK_THAT(again.err, Contains("is there already"));
    CHECK_THAT(folder.read("other/other.cpp"), Contains("\"sink\""));
}

TEST_CASE("names that could not become a library, a class and an id are refused") {
    const TemporaryFolder folder;
    for (const std::string name : {"", "Drag", "9lives", "a-b", "a/b", "../up", "_x", "a b"}) {
        CAPTURE(name);
        const Ended ended = pelorus_command({"new", "motion", name, "--dir", folder.path().string()});
        CHECK(ended.exit == 2);
        CHECK_THAT(ended.err, Contains("lower-case letters"));
    }
    CHECK(pelorus_command({"new", "motion", std::string(65, 'a'), "--dir", folder.path().string()}).exit == 2);
    CHECK(std::filesystem::is_empty(folder.path()));
}

TEST_CASE("a folder that cannot be made is told") {
    const Ended ended = pelorus_command({"new", "motion", "drag", "--dir", "/nonexistent"});
    CHECK(ended.exit == 2);
    CHECK_THAT(ended.err, Contains("cannot make /nonexistent/drag"));
}
