// Text as HTML and SVG hold it.
#pragma once

#include <string>

namespace wetcurl {

// As text or as the value of an attribute: what is read as markup is escaped, control characters, which HTML
// forbids, are U+FFFD.
inline std::string escaped(const std::string& text) {
    std::string out;
    for (const char c : text) switch (c) {
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
            case '\'':
                out += "&#39;";
                break;
            case '\n':
            case '\t':
                out += c;
                break;
            default:
                if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f)
                    out += "\xef\xbf\xbd";
                else
                    out += c;
        }
    return out;
}

}  // namespace wetcurl
