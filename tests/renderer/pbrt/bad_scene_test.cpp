// A table of bad scenes, each with its exact message.
#include <gtest/gtest.h>

#include <string>

#include "renderer/description/description_builder.h"
#include "tests/renderer/pbrt/parse_helpers.h"

namespace tessera {
namespace {

struct BadScene {
  const char* text;
  const char* message;
};

const BadScene kLexical[] = {
    {"Camera \"persp", "a.pbrt:1:8: unterminated string, expected '\"' before the end of the line"},
    {"\n  Camera \"persp\n\"", "a.pbrt:2:10: unterminated string, expected '\"' before the end of the line"},
    {"Camera \"a\\", "a.pbrt:1:8: unterminated string, expected '\"' before the end of the line"},
    {"Camera \"a\\qb\"",
     "a.pbrt:1:8: unknown escape in a string, expected \\b \\f \\n \\r \\t \\\\ \\' or \\\""},
    {"Camera \"\xff\"", "a.pbrt:1:8: string that is not UTF-8"},
    {"\xff\xfe"
     "C",
     "a.pbrt:1:1: the file is UTF-16, expected UTF-8"},
    {"Sha\xffpe", "a.pbrt:1:1: unknown directive \"Sha?pe\" (did you mean \"Shape\"?)"},
};

const BadScene kStructure[] = {
    {"", "a.pbrt:1:1: the file ends without WorldBegin"},
    {"# only\nCamera \"perspective\"\n", "a.pbrt:3:1: the file ends without WorldBegin"},
    {"WorldBegn", "a.pbrt:1:1: unknown directive \"WorldBegn\" (did you mean \"WorldBegin\"?)"},
    {"worldbegin", "a.pbrt:1:1: unknown directive \"worldbegin\" (did you mean \"WorldBegin\"?)"},
    {"Qwertyuiopasdf", "a.pbrt:1:1: unknown directive \"Qwertyuiopasdf\""},
    {"WorldBegin\nWorldEnd",
     "a.pbrt:2:1: unknown directive \"WorldEnd\": pbrt-v4 has none, the world ends with the file"},
    {"WorldBegin WorldBegin", "a.pbrt:1:12: WorldBegin is not allowed after WorldBegin, expected it before"},
    {"WorldBegin\nCamera \"perspective\"",
     "a.pbrt:2:1: Camera is not allowed after WorldBegin, expected it before"},
    {"Shape \"sphere\"", "a.pbrt:1:1: Shape is not allowed here, expected WorldBegin before it"},
    {"ReverseOrientation",
     "a.pbrt:1:1: ReverseOrientation is not allowed here, expected WorldBegin before it"},
    {"Import \"b\"", "a.pbrt:1:1: Import is not allowed here, expected WorldBegin before it"},
    {"WorldBegin ObjectEnd", "a.pbrt:1:12: ObjectEnd without ObjectBegin before it"},
    {"WorldBegin\n AttributeBegin",
     "a.pbrt:2:2: AttributeBegin without AttributeEnd before the end of the file"},
    {"WorldBegin\n ObjectBegin \"o\"",
     "a.pbrt:2:2: ObjectBegin without ObjectEnd before the end of the file"},
    {"WorldBegin\nObjectBegin \"o\"\nAttributeEnd",
     "a.pbrt:3:1: AttributeEnd does not match the ObjectBegin at a.pbrt:2:1"},
    {"WorldBegin\nObjectBegin \"o\"\nAttributeBegin ObjectEnd",
     "a.pbrt:3:16: ObjectEnd does not match the AttributeBegin at a.pbrt:3:1"},
    {"WorldBegin ObjectBegin \"o\"\nObjectBegin \"p\"",
     "a.pbrt:2:1: ObjectBegin inside the definition of object \"o\", expected ObjectEnd first"},
    {"WorldBegin ObjectBegin \"o\"\nObjectInstance \"o\"",
     "a.pbrt:2:1: ObjectInstance inside the definition of object \"o\", expected ObjectEnd first"},
    {"WorldBegin\n]", "a.pbrt:2:1: unexpected \"]\", expected a directive"},
    {"WorldBegin\n\"float x\" 1", "a.pbrt:2:1: unexpected string \"float x\", expected a directive"},
    {"Translate 1 2 3 4", "a.pbrt:1:17: unexpected \"4\", expected a directive"},
};

const BadScene kSyntax[] = {
    {"Camera perspective", "a.pbrt:1:8: unexpected \"perspective\", expected the kind of Camera in quotes"},
    {"Camera", "a.pbrt:1:7: unexpected end of the file, expected the kind of Camera in quotes"},
    {"Translate 1 2", "a.pbrt:1:14: unexpected end of the file, expected number 3 of the 3 of Translate"},
    {"Translate [1 2 3]",
     "a.pbrt:1:11: unexpected \"[\", expected the 3 numbers of Translate without brackets"},
    {"Rotate x 1 0 0", "a.pbrt:1:8: unexpected \"x\", expected number 1 of the 4 of Rotate"},
    {"Rotate 1 inf 0 0", "a.pbrt:1:10: unexpected \"inf\", expected number 2 of the 4 of Rotate"},
    {"Scale 1 2 3#4", "a.pbrt:1:11: unexpected \"3#4\", expected number 3 of the 3 of Scale"},
    {"LookAt 0 0 0 0 0 1 0 1 \"0\"",
     "a.pbrt:1:24: unexpected string \"0\", expected number 9 of the 9 of LookAt"},
    {"Transform 1 0 0 0", "a.pbrt:1:11: unexpected \"1\", expected \"[\" before the 16 numbers of Transform"},
    {"Transform [1 0 0 0]", "a.pbrt:1:19: unexpected \"]\", expected number 5 of the 16 of Transform"},
    {"ConcatTransform [1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1 1]",
     "a.pbrt:1:50: unexpected \"1\", expected \"]\" after the 16 numbers of ConcatTransform"},
    {"Scale 1 0 1 Camera \"perspective\"",
     "a.pbrt:1:13: the transformation of the camera has no inverse, expected finite numbers and no scale of "
     "zero"},
    {"Scale 1e30 1 1\nScale 1e30 1 1",
     "a.pbrt:2:1: after Scale the current transformation is too large for a float, expected finite numbers"},
    {"Rotate 10 0 0 0", "a.pbrt:1:1: Rotate about the axis 0 0 0, expected a direction"},
    {"LookAt 1 2 3 1 2 3 0 1 0",
     "a.pbrt:1:1: LookAt has no direction of view, expected two different points and an up vector that is "
     "not "
     "parallel to the view"},
    {"LookAt 0 0 0 0 0 5 0 0 1",
     "a.pbrt:1:1: LookAt has no direction of view, expected two different points and an up vector that is "
     "not "
     "parallel to the view"},
    {"ActiveTransform Both", "a.pbrt:1:17: unexpected \"Both\", expected All, StartTime or EndTime"},
    {"Attribute \"shap\" \"float x\" 1",
     "a.pbrt:1:1: unknown Attribute target \"shap\" (did you mean \"shape\"?), expected one of shape light "
     "material "
     "medium texture"},
    {"Option \"sede\" 1", "a.pbrt:1:8: unknown option \"sede\" (did you mean \"seed\"?)"},
    {"Option \"seed\" true",
     "a.pbrt:1:15: unexpected \"true\", expected a 32-bit integer for \"integer seed\""},
    {"Option \"Wave-Front\" \"true\"",
     "a.pbrt:1:21: unexpected string \"true\", expected true or false without quotes for \"bool "
     "wavefront\""},
    {"Option \"rendercoordsys\" \"wrld\"",
     "a.pbrt:1:25: unknown coordinate system \"wrld\" (did you mean \"world\"?), expected one of camera "
     "cameraworld "
     "world"},
    {"WorldBegin Texture \"t\" \"color\" \"constant\"",
     "a.pbrt:1:24: unknown texture type \"color\" (pbrt-v4 calls it \"spectrum\"), expected \"float\" or "
     "\"spectrum\""},
};

const BadScene kParameters[] = {
    {"Camera \"p\" \"fov\" 1", "a.pbrt:1:12: \"fov\" is not a parameter, expected \"type name\""},
    {"Camera \"p\" \"  \" 1", "a.pbrt:1:12: \"  \" is not a parameter, expected \"type name\""},
    {"Camera \"p\" \"flaot fov\" 1",
     "a.pbrt:1:12: unknown parameter type \"flaot\" (did you mean \"float\"?), expected one of bool float "
     "integer point2 "
     "vector2 point3 vector3 normal string texture rgb blackbody spectrum"},
    {"Camera \"p\" \"color L\" 1",
     "a.pbrt:1:12: unknown parameter type \"color\" (pbrt-v4 calls it \"rgb\"), expected one of bool float "
     "integer point2 "
     "vector2 point3 vector3 normal string texture rgb blackbody spectrum"},
    {"Camera \"p\" \"float fov\" [ 1 2",
     "a.pbrt:1:29: unexpected end of the file, expected \"]\" after the values of \"float fov\""},
    {"Camera \"p\" \"float fov\" [ ]", "a.pbrt:1:12: \"float fov\" has no values, expected at least one"},
    {"Camera \"p\" \"float fov\" [ 1 [ 2 ]",
     "a.pbrt:1:28: unexpected \"[\", expected a number for \"float fov\""},
    {"Camera \"p\" \"float fov\" WorldBegin",
     "a.pbrt:1:24: unexpected \"WorldBegin\", expected a number for \"float fov\""},
    {"Camera \"p\" \"float fov\"",
     "a.pbrt:1:23: unexpected end of the file, expected a number for \"float fov\""},
    {"Camera \"p\" \"float fov\" 1e99",
     "a.pbrt:1:24: unexpected \"1e99\", expected a number for \"float fov\""},
    {"Camera \"p\" \"float fov\" nan",
     "a.pbrt:1:24: unexpected \"nan\", expected a number for \"float fov\""},
    {"Camera \"p\" \"float fov\" 1x", "a.pbrt:1:24: unexpected \"1x\", expected a number for \"float fov\""},
    {"Camera \"p\" \"integer n\" 1.5",
     "a.pbrt:1:24: unexpected \"1.5\", expected a 32-bit integer for \"integer n\""},
    {"Camera \"p\" \"integer n\" 3000000000",
     "a.pbrt:1:24: unexpected \"3000000000\", expected a 32-bit integer for \"integer n\""},
    {"Camera \"p\" \"bool b\" \"true\"",
     "a.pbrt:1:21: unexpected string \"true\", expected true or false without quotes for \"bool b\""},
    {"Camera \"p\" \"bool b\" [ true 1 ]",
     "a.pbrt:1:28: unexpected \"1\", expected true or false without quotes for \"bool b\""},
    {"Camera \"p\" \"string s\" 1", "a.pbrt:1:23: unexpected \"1\", expected a string for \"string s\""},
    {"Camera \"p\" \"spectrum s\" [ \"a\" 1 ]",
     "a.pbrt:1:31: unexpected \"1\", expected all numbers or one name for \"spectrum s\""},
    {"Camera \"p\" \"spectrum s\" [ 1 \"a\" ]",
     "a.pbrt:1:29: unexpected string \"a\", expected all numbers or one name for \"spectrum s\""},
    {"Camera \"p\" \"float fov\" 1 \"float x",
     "a.pbrt:1:26: unterminated string, expected '\"' before the end of the line"},
};

const BadScene kNames[] = {
    {"WorldBegin MakeNamedMaterial \"m\" \"float x\" 1",
     "a.pbrt:1:12: MakeNamedMaterial \"m\" has no kind, expected a parameter \"string type\""},
    {"MakeNamedMedium \"m\"",
     "a.pbrt:1:1: MakeNamedMedium \"m\" has no kind, expected a parameter \"string type\""},
    {"MakeNamedMedium \"m\" \"string type\" [ \"a\" \"b\" ]",
     "a.pbrt:1:21: \"string type\" of MakeNamedMedium \"m\" has 2 values, expected 1"},
    {"MakeNamedMedium \"m\" \"string type\" \"cloud\"\nMakeNamedMedium \"m\" \"string type\" \"cloud\"",
     "a.pbrt:2:1: medium \"m\" is defined twice, first at a.pbrt:1:1"},
    {"WorldBegin\nMakeNamedMaterial \"m\" \"string type\" \"diffuse\"\nMakeNamedMaterial \"m\" \"string "
     "type\" \"mix\"",
     "a.pbrt:3:1: material \"m\" is defined twice, first at a.pbrt:2:1"},
    {"WorldBegin\nTexture \"t\" \"float\" \"a\"\nTexture \"t\" \"spectrum\" \"a\"\nTexture \"t\" \"float\" "
     "\"b\"",
     "a.pbrt:4:1: float texture \"t\" is defined twice, first at a.pbrt:2:1"},
    {"WorldBegin\nObjectBegin \"o\" ObjectEnd\nObjectBegin \"o\" ObjectEnd",
     "a.pbrt:3:1: object \"o\" is defined twice, first at a.pbrt:2:1"},
    {"WorldBegin\nObjectBegin \"chair\" ObjectEnd\nObjectInstance \"chiar\"",
     "a.pbrt:3:1: object \"chiar\" is not defined, expected the name of an ObjectBegin (did you mean "
     "\"chair\"?)"},
    {"WorldBegin MakeNamedMaterial \"gold\" \"string type\" \"conductor\"\nNamedMaterial \"glod\"\n Shape "
     "\"sphere\"",
     "a.pbrt:3:2: material \"glod\" is not defined (did you mean \"gold\"?)"},
    {"WorldBegin MediumInterface \"fog\" \"\"\nShape \"sphere\"",
     "a.pbrt:2:1: medium \"fog\" is not defined"},
    {"WorldBegin MediumInterface \"\" \"fog\"\nLightSource \"point\"",
     "a.pbrt:2:1: medium \"fog\" is not defined"},
    {"MediumInterface \"\" \"fog\"\nCamera \"perspective\" WorldBegin",
     "a.pbrt:2:1: medium \"fog\" is not defined"},
};

template <size_t N>
void CheckTable(const BadScene (&table)[N]) {
  for (const BadScene& bad : table) {
    const Result<SceneDescription> scene = ParseText(bad.text);
    EXPECT_EQ(ErrorOf(scene), bad.message) << "for:\n" << bad.text;
    EXPECT_TRUE(scene || scene.error().kind == ErrorKind::kBadInput);
  }
}

TEST(BadScene, LexicalErrorsAreToldWithTheirPlace) {
  CheckTable(kLexical);
}
TEST(BadScene, DirectivesInTheWrongPlaceAreToldWithTheirPlace) {
  CheckTable(kStructure);
}
TEST(BadScene, WrongArgumentsAreToldWithTheirPlace) {
  CheckTable(kSyntax);
}
TEST(BadScene, WrongParameterListsAreToldWithTheirPlace) {
  CheckTable(kParameters);
}
TEST(BadScene, UndefinedAndRedefinedNamesAreToldWithTheirPlace) {
  CheckTable(kNames);
}

TEST(BadScene, ZeroBytesAreRefused) {
  EXPECT_EQ(ErrorOf(ParseText(std::string("WorldBegin\nSha\0pe", 17))),
            "a.pbrt:2:1: zero byte, expected text: is this a scene file?");
  EXPECT_EQ(ErrorOf(ParseText(std::string("Camera \"\0\"", 10))), "a.pbrt:1:8: zero byte in a string");
}

TEST(BadScene, LongStringsAndNamesAreRefused) {
  const std::string long_string(kStringLengthMax + 1, 'x'), long_name(5000, 'x');
  EXPECT_EQ(ErrorOf(ParseText("Camera \"" + long_string + "\"")),
            "a.pbrt:1:8: string longer than 65536 bytes");
  EXPECT_EQ(ErrorOf(ParseText("Camera \"" + long_name + "\"")),
            "a.pbrt:1:1: the kind of Camera is longer than 4096 bytes");
}

TEST(BadScene, LargeDefaultsAreRefused) {
  std::string text = "Attribute \"shape\" \"float x\" [";
  for (int i = 0; i < 20000; ++i) text += " 1";
  EXPECT_EQ(ErrorOf(ParseText(text + " ]")),
            "a.pbrt:1:1: the defaults of Attribute \"shape\" hold more than 65536 bytes");
}

TEST(BadScene, DescriptionsBeyondAllBoundsAreRefused) {
  DescriptionBuilder copies("a.pbrt"), whole("a.pbrt");
  EXPECT_TRUE(copies.ChargeCopy(copies.top(), kCopiedSizeMax));
  EXPECT_FALSE(copies.ChargeCopy(copies.top(), 1));
  EXPECT_EQ(copies.Finish().error().message, "a.pbrt:1:1: copied defaults hold more than 4294967296 bytes");
  EXPECT_TRUE(whole.Charge(whole.top(), kDescriptionSizeMax));
  EXPECT_FALSE(whole.Charge(whole.top(), 1));
  EXPECT_EQ(whole.Finish().error().message,
            "a.pbrt:1:1: the scene describes more than 68719476736 bytes of data");
}

TEST(BadScene, AttributesNestedTooDeepAreRefused) {
  std::string text = "WorldBegin\n";
  for (int i = 0; i <= 65536; ++i) text += "AttributeBegin\n";
  EXPECT_EQ(ErrorOf(ParseText(text)), "a.pbrt:65538:1: AttributeBegin nested deeper than 65536");
}

TEST(BadScene, MessagesQuoteOnlyTheBeginningOfLongTokens) {
  EXPECT_EQ(ErrorOf(ParseText(std::string(1000, 'y'))),
            "a.pbrt:1:1: unknown directive \"" + std::string(60, 'y') + "...\"");
}

}  // namespace
}  // namespace tessera
