/* The host's console. */
#include "text.h"
#include <stdio.h>

void port_write(const char *text)
{
    (void)fputs(text, stdout);
}
