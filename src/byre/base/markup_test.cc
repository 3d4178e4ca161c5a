#include "byre/base/markup.h"

#include <gtest/gtest.h>

namespace byre {
namespace {

TEST(Markup, EscapesText) {
  EXPECT_EQ(markup_escaped("a < b & \"c\" > d"), "a &lt; b &amp; &quot;c&quot; &gt; d");
}

TEST(Markup, RemovesControlCharacters) {
  EXPECT_EQ(markup_escaped("plan\x1b\xc2\x9b<2>"), "plan\\x1b\\xc2\\x9b&lt;2&gt;");
}

}  // namespace
}  // namespace byre
