// `chat` of main.rs by Fast DDS: fast chat DIR NUMBER SECONDS DOMAIN.
#include <chrono>
#include <cstdio>
#include <cstring>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/dds/topic/Topic.hpp>
#include <fastdds/dds/topic/TopicDataType.hpp>
#include <fastdds/dds/topic/TypeSupport.hpp>
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <functional>
#include <map>
#include <string>
#include <thread>

using namespace eprosima::fastdds::dds;

// One word: header of CDR, length, padding, word.
struct SampleType : TopicDataType {
    SampleType() { setName("Sample"); m_typeSize = 64; m_isGetKeyDefined = false; }
    bool serialize(void *data, eprosima::fastrtps::rtps::SerializedPayload_t *payload) override {
        unsigned char bytes[20] = {0, 1, 0, 0, 1};
        memcpy(bytes + 12, data, 8);
        memcpy(payload->data, bytes, 20);
        payload->length = 20;
        payload->encapsulation = CDR_LE;
        return true;
    }
    bool deserialize(eprosima::fastrtps::rtps::SerializedPayload_t *payload, void *data) override {
        if (payload->length < 20) return false;
        memcpy(data, payload->data + 12, 8);
        return true;
    }
    std::function<uint32_t()> getSerializedSizeProvider(void *) override { return [] { return 64u; }; }
    void *createData() override { return new uint64_t(0); }
    void deleteData(void *data) override { delete static_cast<uint64_t *>(data); }
    bool getKey(void *, eprosima::fastrtps::rtps::InstanceHandle_t *, bool) override { return false; }
};

int main(int, char **argv) {
    std::string dir = argv[2];
    uint64_t number = std::stoul(argv[3]);
    int seconds = std::stoi(argv[4]), domain = std::stoi(argv[5]);
    DomainParticipantQos qos;
    auto set = [&](const char *key, std::string value) { qos.properties().properties().emplace_back(key, value); };
    // Datagrams alone: shared memory reaches no other vendor.
    auto udp = std::make_shared<eprosima::fastdds::rtps::UDPv4TransportDescriptor>();
    udp->interfaceWhiteList = {"127.0.0.1"};
    qos.transport().use_builtin_transports = false;
    qos.transport().user_transports = {udp};
    if (dir != "-") {
        std::string file = "file://" + dir + "/", auth = "dds.sec.auth.builtin.PKI-DH.";
        std::string access = "dds.sec.access.builtin.Access-Permissions.";
        set("dds.sec.auth.plugin", "builtin.PKI-DH");
        set((auth + "identity_ca").c_str(), file + "identity_ca.cert.pem");
        set((auth + "identity_certificate").c_str(), file + "cert.pem");
        set((auth + "private_key").c_str(), file + "key.pem");
        set("dds.sec.access.plugin", "builtin.Access-Permissions");
        set((access + "permissions_ca").c_str(), file + "permissions_ca.cert.pem");
        set((access + "governance").c_str(), file + "governance.p7s");
        set((access + "permissions").c_str(), file + "permissions.p7s");
        set("dds.sec.crypto.plugin", "builtin.AES-GCM-GMAC");
    }
    auto *participant = DomainParticipantFactory::get_instance()->create_participant(domain, qos);
    if (!participant) return puts("refused: no participant"), 0;
    TypeSupport type(new SampleType);
    type.register_type(participant);
    auto *topic = participant->create_topic("chat", "Sample", TOPIC_QOS_DEFAULT);
    DataWriterQos writes;
    writes.reliability().kind = RELIABLE_RELIABILITY_QOS;
    DataReaderQos reads;
    writes.data_sharing().off();
    reads.data_sharing().off();
    reads.history().depth = 16; // of this participant and the other
    reads.reliability().kind = RELIABLE_RELIABILITY_QOS;
    auto *writer = participant->create_publisher(PUBLISHER_QOS_DEFAULT)->create_datawriter(topic, writes);
    auto *reader = participant->create_subscriber(SUBSCRIBER_QOS_DEFAULT)->create_datareader(topic, reads);
    if (!writer || !reader) return puts("refused: no writer or no reader"), 0;
    std::map<uint64_t, int> heard;
    for (int i = 0; i < 20 * seconds; i++) {
        writer->write(&number);
        uint64_t got;
        SampleInfo info;
        while (reader->take_next_sample(&got, &info) == ReturnCode_t::RETCODE_OK)
            if (info.valid_data && got != number) heard[got]++;
        std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
    printf("heard {");
    for (auto [who, count] : heard) printf("%d: %d", (int)who, count);
    puts("}");
    participant->delete_contained_entities();
    DomainParticipantFactory::get_instance()->delete_participant(participant);
}
