#include "cli/draw/drawing.hpp"
#include "cli/value_json.hpp"

namespace pelorus::cli {

namespace {

using Json = nlohmann::ordered_json;

/// Of what HTML-like labels and quoted strings may hold.
std::string escaped(const std::string& text) {
    std::string out;
    for (const char c : text) {
        switch (c) {
            case '&':
                out += "&amp;";
                break;
            case '<':
                out += "&lt;";
                break;
            case '>':
                out += "&gt;";
                break;
            case '"':
                out += "&quot;";
                break;
            case '\\':
                out += "&#92;";
                break;
            default:
                out += c;
        }
    }
    return out;
}

std::string row(const std::string& content) { return "<TR><TD ALIGN=\"LEFT\">" + content + "</TD></TR>"; }

/// A box with a heading, the values that are not the defaults, and a box for each part.
std::string box(const std::string& name, const Json& part) {
    std::string text = "<TABLE BORDER=\"1\" CELLBORDER=\"0\" CELLSPACING=\"2\" CELLPADDING=\"2\">" +
                       row("<B>" + escaped(name) + "</B>  " + escaped(part["use"].get<std::string>()));
    for (const auto& [key, value] : part["with"].items()) text += row(escaped(key + ": " + flow_text(value)));
    for (const Json& below : part["parts"]) {
        const std::string slot = below["slot"], own = below["name"];
        text += row(box(own.empty() ? slot : slot + "." + own, below));
    }
    return text + "</TABLE>";
}

std::string edge_line(const Json& edge) {
    const std::string from = edge["from"], to = edge["to"];
    const std::string out = from.substr(from.find('.') + 1), in = to.substr(to.find('.') + 1);
    std::string label = escaped(out == in ? out : out + " > " + in) + " (" + edge["message"].get<std::string>() + ")";
    for (const Json& stream : edge["streams"]) {
        std::string text = escaped(stream_text(stream));
        for (std::size_t at = 0; (at = text.find("; ", at)) != std::string::npos; ++at) text.replace(at, 2, ";\\l");
        label += "\\l" + text;
    }
    return "  \"" + from.substr(0, from.find('.')) + "\" -> \"" + to.substr(0, to.find('.')) + "\" [label=\"" + label +
           "\\l\"" + (edge["feedback"] == true ? ", style=dashed, constraint=false" : "") + "];\n";
}

}  // namespace

std::string graph_dot(const Json& graph) {
    std::string text = "digraph pelorus {\n  graph [label=\"" + escaped(graph["title"].get<std::string>()) +
                       "\", labelloc=t, rankdir=TB, fontname=\"sans-serif\"];\n"
                       "  node [shape=plain, fontname=\"sans-serif\", fontsize=11];\n"
                       "  edge [fontname=\"sans-serif\", fontsize=9];\n";
    for (const Json& node : graph["nodes"]) {
        const std::string name = node["name"];
        text += "  \"" + name + "\" [label=<" + box(name, node) + ">];\n";
    }
    for (const Json& edge : graph["edges"]) text += edge_line(edge);
    return text + "}\n";
}

}  // namespace pelorus::cli
