#include "coordinator/web/html.h"

#include <gtest/gtest.h>

namespace tessera {
namespace {

TEST(Html, EscapesTextAndAttributes) {
  Html html;
  html.Element("td", "<b>&\"'", {{"title", "\"><script>"}});
  EXPECT_EQ(html.Take(), "<td title=\"&quot;&gt;&lt;script&gt;\">&lt;b&gt;&amp;&quot;&#39;</td>");
}

TEST(Html, ClosesElementsInTheirOrder) {
  Html html;
  html.Open("p").Text("a").Open("b").Text("c").Close().Void("br").Close();
  EXPECT_EQ(html.Take(), "<p>a<b>c</b><br></p>");
}

TEST(Html, ControlCharactersAndBytesThatAreNotUtf8DoNotReachThePage) {
  Html html;
  html.Text("a\x01\xff\xe2\x80\xae");
  EXPECT_EQ(html.Take(), "a \xef\xbf\xbd\xef\xbf\xbd");
}

}  // namespace
}  // namespace tessera
