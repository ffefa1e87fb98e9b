// The attributes of a picture's header, which a frame holds as text (FrameSpec::attributes): which of them
// are written as another type than string, as other programs expect them. The text of numbers is the shortest
// that gives the same number; matrices are row by row and act on row vectors, as those of OpenEXR.
#pragma once

#include <ImfHeader.h>

#include <optional>
#include <string>

namespace tessera {

// Whether it describes the file itself, so that the writer alone sets it.
bool IsReservedAttribute(const std::string& name);
// Whether the attribute is written as another type than string.
bool IsTypedAttribute(const std::string& name);
// Whether the text is a value of the attribute.
bool IsAttributeValue(const std::string& name, const std::string& text);
// Adds the attribute, as a string if the text is no value of it.
void AddAttribute(const std::string& name, const std::string& text, Imf::Header& header);

// The value of an attribute as text, as AddAttribute takes it; nullopt if it has none.
std::optional<std::string> AttributeText(const Imf::Attribute& attribute);

}  // namespace tessera
