#include "text.h"

void put(const char *text)
{
    port_write(text);
}

void put_line(const char *text)
{
    put(text);
    put("\n");
}

void put_number(int32_t number)
{
    char digits[12];
    size_t place = sizeof digits - 1u;
    uint32_t rest = number < 0 ? 0u - (uint32_t)number : (uint32_t)number;

    digits[place] = '\0';
    do {
        place -= 1u;
        digits[place] = (char)('0' + (char)(rest % 10u));
        rest /= 10u;
    } while (rest > 0u);
    put(number < 0 ? "-" : "");
    put(&digits[place]);
}

void put_fixed(float value)
{
    const int is_number = (value > -1.0e6f) && (value < 1.0e6f);
    int32_t hundredths;

    if (!is_number) {
        put("out of range");
        return;
    }
    hundredths = (int32_t)(value * 100.0f + (value < 0.0f ? -0.5f : 0.5f));
    put(hundredths < 0 ? "-" : "");
    hundredths = hundredths < 0 ? -hundredths : hundredths;
    put_number(hundredths / 100);
    put(hundredths % 100 < 10 ? ".0" : ".");
    put_number(hundredths % 100);
}

static void put_bits(float value)
{
    static const char hex[] = "0123456789abcdef";
    union {
        float value;
        uint32_t bits;
    } number;
    char digits[9];
    size_t i;

    number.value = value;
    for (i = 0u; i < 8u; i++) {
        digits[i] = hex[(number.bits >> (28u - 4u * i)) & 15u];
    }
    digits[8] = '\0';
    put(" [");
    put(digits);
    put("]");
}

static void put_reason(const cede_reason *reason)
{
    put(": ");
    put(cede_reason_text(reason->kind));
    put(", track ");
    put_number((int32_t)reason->other);
    put(": ");
    put_fixed(reason->available);
    put(reason->kind == CEDE_REASON_KIND_ARRIVAL ? " s, needed are " : " m, needed are ");
    put_fixed(reason->needed);
}

static void put_fault(const cede_fault *fault)
{
    put(": ");
    put(cede_fault_text(fault->kind));
    if (fault->kind == CEDE_FAULT_KIND_INPUT) {
        put(": ");
        put(cede_subject_text(fault->subject));
        put(" ");
        put_number((int32_t)fault->track);
        put(", ");
        put(cede_field_text(fault->field));
        put(" ");
        put_fixed(fault->value);
    }
}

void put_decision(const cede_decision *decision)
{
    put("a = ");
    put_fixed(decision->acceleration);
    put_bits(decision->acceleration);
    put(", margin ");
    put_fixed(decision->margin);
    put_bits(decision->margin);
    put(", ");
    put(cede_cause_text(decision->cause));
    if (decision->cause == CEDE_CAUSE_SHIELDED) {
        put_reason(&decision->reason);
    } else if (decision->cause == CEDE_CAUSE_FALLBACK) {
        put_fault(&decision->fallback);
    } else {
        /* The policy's proposal is safe: there is no more to say. */
    }
    if (decision->breach != CEDE_BREACH_NONE) {
        put("; ");
        put(cede_breach_text(decision->breach));
    }
    put("\n");
}

void put_refusal(const cede_detail *detail)
{
    put(cede_status_text(detail->status));
    if (detail->contract_field != CEDE_CONTRACT_FIELD_NONE) {
        put(": ");
        put(cede_contract_field_text(detail->contract_field));
        put(" = ");
        put_fixed(detail->value);
        put(" is outside ");
        put(detail->excludes_low != 0u ? "(" : "[");
        put_fixed(detail->low);
        put(", ");
        put_fixed(detail->high);
        put(detail->excludes_high != 0u ? ")" : "]");
    }
    put("\n");
}
