#include "cli/type_text.hpp"

#include <fmt/format.h>

namespace pelorus::cli {

using Json = nlohmann::ordered_json;

std::string range_text(const Json& range) {
    const int least = range["min"];
    if (!range.contains("max")) return least == 0 ? "any number" : fmt::format("{} or more", least);
    const int most = range["max"];
    return least == most ? std::to_string(least) : fmt::format("{} to {}", least, most);
}

std::string type_text(const Json& parameter) {
    std::string text = parameter["type"].get<std::string>();
    if (parameter.contains("cols"))
        text += " of " + range_text(parameter["rows"]) + " by " + range_text(parameter["cols"]);
    else if (parameter.contains("rows"))
        text += " of " + range_text(parameter["rows"]) + (text == "table" ? " rows" : "");
    if (parameter["unit"] != "") text += " [" + parameter["unit"].get<std::string>() + "]";
    if (!parameter["default"].is_null())
        text += ", default " + parameter["default"].get<std::string>();
    else
        text += parameter["required"].get<bool>() ? ", required" : ", optional";
    for (const auto& [key, words] : {std::pair("min", "at least"), std::pair("above", "above"),
                                     std::pair("max", "at most"), std::pair("below", "below")})
        if (parameter.contains(key)) text += fmt::format(", {} {:g}", words, parameter[key].get<double>());
    return text;
}

}  // namespace pelorus::cli
