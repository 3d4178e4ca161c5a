#include "byre/input/markup.h"

#include <gtest/gtest.h>

namespace byre {
namespace {

TEST(Markup, IsEscapedInText) {
  EXPECT_EQ(markup_escaped("a < b & \"c\" > d"), "a &lt; b &amp; &quot;c&quot; &gt; d");
}

}  // namespace
}  // namespace byre
