// The page's style sheet and script, as text. Private to page.cpp.
#pragma once
#include <string_view>

namespace gonio::report {

extern const std::string_view page_style, page_script;

}  // namespace gonio::report
