#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>

#include "reports/text.h"

namespace morphodesic::reports {
namespace {

TEST(Text, KeepsValidUtf8) {
    for (const char* s : {"", "plain", "Blätter", "葉", "🍂", "a\tb\n"}) EXPECT_EQ(valid_utf8(s), s);
}

TEST(Text, ReplacesEachByteThatIsNotUtf8) {
    const std::string r = "\xEF\xBF\xBD";
    EXPECT_EQ(valid_utf8("a\xFF"
                         "b"),
              "a" + r + "b");
    EXPECT_EQ(valid_utf8("\xC3"), r);                          // cut short
    EXPECT_EQ(valid_utf8("\xC0\xAF"), r + r);                  // overlong '/'
    EXPECT_EQ(valid_utf8("\xE0\x80\xAF"), r + r + r);          // overlong
    EXPECT_EQ(valid_utf8("\xED\xA0\x80"), r + r + r);          // surrogate
    EXPECT_EQ(valid_utf8("\xF4\x90\x80\x80"), r + r + r + r);  // beyond U+10FFFF
}

TEST(Text, EscapesMarkup) {
    EXPECT_EQ(escape_markup("<img src=x onerror='alert(1)'>&\""),
              "&lt;img src=x onerror=&#39;alert(1)&#39;&gt;&amp;&quot;");
    EXPECT_EQ(escape_markup(std::string("a\0b\x1b", 4)),
              "a\xEF\xBF\xBD"
              "b\xEF\xBF\xBD");
    EXPECT_EQ(escape_markup("a\nb"), "a b");
}

TEST(Text, Base64OfRfc4648) {
    EXPECT_EQ(base64(""), "");
    EXPECT_EQ(base64("f"), "Zg==");
    EXPECT_EQ(base64("fo"), "Zm8=");
    EXPECT_EQ(base64("foo"), "Zm9v");
    EXPECT_EQ(base64("foobar"), "Zm9vYmFy");
    EXPECT_EQ(base64("\xFF\xFE\x00"), "//4=");  // the literal ends at its zero
}

TEST(Text, DataUriTakesPicturesOnly) {
    EXPECT_EQ(data_uri("\x89PNG\r\n\x1a\n").substr(0, 22), "data:image/png;base64,");
    EXPECT_EQ(data_uri(""), "");
    EXPECT_THROW((void)data_uri("<svg onload='alert(1)'/>"), std::invalid_argument);
}

TEST(Text, ShortNumbers) {
    EXPECT_EQ(short_number(0.123456), "0.123");
    EXPECT_EQ(short_number(std::numeric_limits<double>::quiet_NaN()), "–");
}

TEST(Text, SharesOfNothingAreNothing) {
    EXPECT_EQ(share_text(0.1234), "12.3 %");
    EXPECT_EQ(share_text(1.0), "100 %");
    EXPECT_EQ(share_text(0.0), "0 %");
    EXPECT_EQ(share_text(1.95e-17), "0 %");
    EXPECT_EQ(share_text(2.7e-6), "< 0.1 %");
    EXPECT_EQ(share_text(std::numeric_limits<double>::quiet_NaN()), "–");
}

}  // namespace
}  // namespace morphodesic::reports
