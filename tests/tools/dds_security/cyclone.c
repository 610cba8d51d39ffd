// `chat` of main.rs by CycloneDDS: cyclone chat DIR NUMBER SECONDS DOMAIN.
#include "dds/dds.h"
#include "sample.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void file(dds_qos_t *qos, const char *dir, const char *property, const char *name) {
    char key[200], value[4096];
    snprintf(key, sizeof key, "dds.sec.%s", property);
    snprintf(value, sizeof value, "file:%s/%s", dir, name);
    dds_qset_prop(qos, key, value);
}

static void plugin(dds_qos_t *qos, const char *kind, const char *library, const char *start, const char *end) {
    const char *parts[3][2] = {{"path", library}, {"init", start}, {"finalize", end}};
    for (int i = 0; i < 3; i++) {
        char key[200];
        snprintf(key, sizeof key, "dds.sec.%s.library.%s", kind, parts[i][0]);
        dds_qset_prop(qos, key, parts[i][1]);
    }
}

int main(int argc, char **argv) {
    const char *dir = argv[2];
    uint64_t number = strtoull(argv[3], NULL, 10), heard[10] = {0};
    int seconds = atoi(argv[4]), domain = atoi(argv[5]);
    dds_qos_t *qos = dds_create_qos();
    if (strcmp(dir, "-")) {
        file(qos, dir, "auth.identity_ca", "identity_ca.cert.pem");
        file(qos, dir, "auth.identity_certificate", "cert.pem");
        file(qos, dir, "auth.private_key", "key.pem");
        file(qos, dir, "access.permissions_ca", "permissions_ca.cert.pem");
        file(qos, dir, "access.governance", "governance.p7s");
        file(qos, dir, "access.permissions", "permissions.p7s");
        plugin(qos, "auth", "dds_security_auth", "init_authentication", "finalize_authentication");
        plugin(qos, "crypto", "dds_security_crypto", "init_crypto", "finalize_crypto");
        plugin(qos, "access", "dds_security_ac", "init_access_control", "finalize_access_control");
    }
    dds_entity_t participant = dds_create_participant(domain, qos, NULL);
    dds_entity_t topic = dds_create_topic(participant, &Sample_desc, "chat", NULL, NULL);
    dds_qos_t *reliable = dds_create_qos();
    dds_qset_reliability(reliable, DDS_RELIABILITY_RELIABLE, DDS_SECS(1));
    dds_qset_history(reliable, DDS_HISTORY_KEEP_LAST, 16);
    dds_entity_t writer = dds_create_writer(participant, topic, reliable, NULL);
    dds_entity_t reader = dds_create_reader(participant, topic, reliable, NULL);
    if (participant < 0 || writer < 0 || reader < 0) {
        printf("refused: %s\n", dds_strretcode(participant < 0 ? participant : writer < 0 ? writer : reader));
        return 0;
    }
    for (int i = 0; i < 20 * seconds; i++) {
        Sample sample = {.words = {._length = 1, ._maximum = 1, ._buffer = &number}};
        dds_write(writer, &sample);
        void *taken[1] = {NULL};
        dds_sample_info_t info[1];
        while (dds_take(reader, taken, info, 1, 1) > 0) {
            Sample *got = taken[0];
            if (info[0].valid_data && got->words._buffer[0] != number) heard[got->words._buffer[0] % 10]++;
            dds_return_loan(reader, taken, 1);
        }
        dds_sleepfor(DDS_MSECS(50));
    }
    for (int i = 0; i < 10; i++)
        if (heard[i]) printf("%d heard %d: %d\n", (int)number, i, (int)heard[i]);
    dds_delete(participant);
}
