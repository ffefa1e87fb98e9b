// What browsers send in forms and cookies.
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <string_view>

namespace tessera {

constexpr size_t kFormFieldsMax = 8;

// The fields of a form as application/x-www-form-urlencoded. Returns nullopt if it is malformed, names a
// field twice or has more than kFormFieldsMax fields.
std::optional<std::map<std::string, std::string>> ParseForm(std::string_view body);

// The value of a cookie in the header Cookie. Returns an empty text if it is not there, or there twice.
std::string CookieValue(std::string_view cookies, std::string_view name);

}  // namespace tessera
