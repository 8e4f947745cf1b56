#include "csv_reader.hpp"

#include <catch2/catch.hpp>

#include "../../../tests/fixtures/temporary_folder.hpp"

namespace {

using source_csv::CsvReader;
using Rows = std::vector<std::vector<std::string>>;

std::vector<std::string> fields(const CsvReader& reader) {
    std::vector<std::string> out;
    for (std::size_t i = 0; i < reader.size(); ++i) out.emplace_back(reader[i]);
    return out;
}

/// All rows; a malformed one as {"!", problem}.
Rows rows_of(CsvReader& reader) {
    Rows rows;
    for (auto answer = reader.next(); answer != CsvReader::Answer::end; answer = reader.next())
        rows.push_back(answer == CsvReader::Answer::row ? fields(reader)
                                                        : std::vector<std::string>{"!", reader.problem()});
    return rows;
}

Rows parse(const std::string& text, char delimiter = ',', const std::string& comment = "") {
    const pelorus::test::TemporaryFolder folder;
    CsvReader reader(folder.write("file.csv", text), delimiter, comment);
    return rows_of(reader);
}

}  // namespace

TEST_CASE("CSV rows are split at delimiters and line ends", "[source.csv]") {
    CHECK(parse("a,b,c\n1,2,3\n") == Rows{{"a", "b", "c"}, {"1", "2", "3"}});
    CHECK(parse("a,b\r\n1,2\r\n") == Rows{{"a", "b"}, {"1", "2"}});
    CHECK(parse("a,b\n1,2") == Rows{{"a", "b"}, {"1", "2"}});
    CHECK(parse("a,,\n,,\n") == Rows{{"a", "", ""}, {"", "", ""}});
    CHECK(parse("a,") == Rows{{"a", ""}});
    CHECK(parse("") == Rows{});
    CHECK(parse("\n\r\n  \n") == Rows{});
    CHECK(parse("a;b|c\n", ';') == Rows{{"a", "b|c"}});
    CHECK(parse("a\t\tb\n", '\t') == Rows{{"a", "", "b"}});
}

TEST_CASE("CSV fields lose the blanks around them, unless they are quoted", "[source.csv]") {
    CHECK(parse(" a , b c \t,\td\n") == Rows{{"a", "b c", "d"}});
    CHECK(parse("\" a \", x\n") == Rows{{" a ", "x"}});
    CHECK(parse("a, \"b\" ,c\n") == Rows{{"a", "b", "c"}});
}

TEST_CASE("CSV quoted fields hold delimiters, line ends and doubled quotes", "[source.csv]") {
    CHECK(parse("\"a,b\",\"c\nd\",\"say \"\"no\"\"\"\r\n1,2,3\n") ==
          Rows{{"a,b", "c\nd", "say \"no\""}, {"1", "2", "3"}});
    CHECK(parse("\"\",x\n") == Rows{{"", "x"}});
    CHECK(parse("5\" gun,x\n") == Rows{{"5\" gun", "x"}});
}

TEST_CASE("CSV fields delimited by blanks are separated by any run of them", "[source.csv]") {
    CHECK(parse("  1   2\t3  \n4 5 6\n", ' ') == Rows{{"1", "2", "3"}, {"4", "5", "6"}});
    CHECK(parse("\"a b\" c\n", ' ') == Rows{{"a b", "c"}});
}

TEST_CASE("CSV comment lines, empty lines and the byte order mark are no rows", "[source.csv]") {
    CHECK(parse("# x,y\n\na,b\n# z\n1,2\n#", ',', "#") == Rows{{"a", "b"}, {"1", "2"}});
    CHECK(parse("// x\n/a,b\n", ',', "//") == Rows{{"/a", "b"}});
    CHECK(parse("# x\n") == Rows{{"# x"}});
    CHECK(parse("\xEF\xBB\xBF"
                "a,b\n1,2\n") == Rows{{"a", "b"}, {"1", "2"}});
}

TEST_CASE("CSV rows that are malformed are told, and reading goes on with the next line", "[source.csv]") {
    CHECK(parse("\"a\"b,c\n1,2\n") == Rows{{"!", "has text after the closing quote of field 1"}, {"1", "2"}});
    CHECK(parse("1,2\n\"a,b\nc,d\n") == Rows{{"1", "2"}, {"!", "ends within a quoted field"}});
    const Rows rows = parse("\"" + std::string(2u << 20, 'x') + "\n1,2\n");
    REQUIRE(rows.size() == 2);
    CHECK(rows[0][1] == "is longer than 1048576 bytes (is a quote not closed?)");
    CHECK(rows[1] == std::vector<std::string>{"1", "2"});
}

TEST_CASE("CSV lines are counted through quoted line ends", "[source.csv]") {
    const pelorus::test::TemporaryFolder folder;
    CsvReader reader(folder.write("file.csv", "\n\"a\nb\",c\n\n1,2\n"), ',', "");
    reader.next();
    CHECK(reader.line() == 2);
    reader.next();
    CHECK(reader.line() == 5);
}

TEST_CASE("CSV is read from gzip as from plain text, told by the content", "[source.csv]") {
    const pelorus::test::TemporaryFolder folder;
    std::string text;
    for (int i = 0; i < 50000; ++i) text += std::to_string(i) + "," + std::to_string(i % 977) + "\n";
    CsvReader plain(folder.write("a.gz", text), ',', ""), packed(folder.write_gzip("b.csv", text), ',', "");
    CHECK(rows_of(plain) == rows_of(packed));
}

TEST_CASE("CSV reading goes on at a place that was noted, compressed or not", "[source.csv]") {
    const pelorus::test::TemporaryFolder folder;
    std::string text;
    for (int i = 0; i < 30000; ++i) text += std::to_string(i) + ",x\n";
    for (const std::string& path : {folder.write("a.csv", text), folder.write_gzip("a.gz", text)}) {
        CsvReader first(path, ',', "");
        for (int i = 0; i < 20000; ++i) first.next();
        const CsvReader::Place place = first.place();
        CsvReader second(path, ',', "");
        second.next();
        second.seek(place);
        CHECK(rows_of(first) == rows_of(second));
        CHECK(first.line() == second.line());
    }
}

TEST_CASE("CSV from a broken gzip ends with what could be read and says why", "[source.csv]") {
    const pelorus::test::TemporaryFolder folder;
    std::string text;
    for (int i = 0; i < 20000; ++i) text += std::to_string(i * 7919 % 10007) + "\n";
    const std::string path = folder.write_gzip("a.gz", text);
    std::string bytes = folder.read("a.gz");
    folder.write("short.gz", bytes.substr(0, bytes.size() / 2));
    CsvReader shorter(folder / "short.gz", ',', "");
    const Rows rows = rows_of(shorter);
    REQUIRE(rows.size() > 1000);
    CHECK(rows.back()[1] == "the compressed data end early");
    CHECK(shorter.broken_off());

    for (std::size_t i = bytes.size() / 2; i < bytes.size() / 2 + 40; ++i) bytes[i] = static_cast<char>(~bytes[i]);
    CsvReader damaged(folder.write("damaged.gz", bytes), ',', "");
    CHECK_THAT(rows_of(damaged).back()[1], Catch::StartsWith("the compressed data are damaged"));
}
